"""A forecast as it goes over /power/forecast."""

from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.values import JointTrajectory, TrajectoryPoint
from sojourn_flight.power_manager.forecast import COLUMNS, PowerForecast


def forecast_message(stamp: int, forecast: PowerForecast) -> JointTrajectory:
    """One point a step, whose positions are the columns of the forecast."""
    rows = zip(forecast.times.tolist(), forecast.values, strict=True)
    points = tuple([TrajectoryPoint(row, time_from_start=round(time * NANOSECONDS)) for time, row in rows])
    return JointTrajectory(stamp, COLUMNS, points)
