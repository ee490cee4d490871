"""How far a record reaches."""

from sojourn_bags.reading import Bag


def sim_time(bag: Bag) -> float:
    """Last stamp of the plant's clock, or of the truth, or of anything [s]."""
    for topic in ("/clock", "/truth/odom"):
        if topic in bag:
            return float(bag[topic].times.max())
    return max((messages.log_times[-1] for messages in bag.topics.values()), default=0) / 1e9
