"""One wheel for every contact law, for tests and the bench: sizes of real ones, and what is estimated.

LRV_WHEEL: 0.813 x 0.229 m, 253 N (Boeing LRV-1-0, Lunar Roving Vehicle Operations Handbook, 1971; Asnani, Delap &
Creager 2009, J. Terramechanics 46:89). Its load against deflection is an estimate: a mesh that gives way by
about 40 mm under the nominal load, stiffens, and meets the bump stop of the inner frame at 70 mm. The
carcass pressure is that load over the footprint of this curve on rigid ground, 2 b sqrt(2 r d - d²): 3 kPa.
"""

from typing import Any

import numpy as np

from sojourn_machine.params import FloatArray
from sojourn_machine.supports import WheelParams
from sojourn_physics.contact.contact_law import WHEEL_COLUMNS, WheelColumn
from sojourn_physics.contact.foot_pad import FootPadParams
from sojourn_physics.contact.law_call import row_entry
from sojourn_physics.contact.law_params import ContactLawParams
from sojourn_physics.contact.rows import wheel_rows
from sojourn_physics.contact.track import LevelTrackParams

LRV_SIZE = {"radius": 0.4065, "width": 0.229}
LRV_MESH = {
    "stiffness": 4.5e3,
    "progressive_stiffness": 45e3,
    "stop_deflection": 0.07,
    "stop_stiffness": 40e3,
    "rolling_resistance": 0.03,
}
LRV_CARCASS = {"carcass_pressure": 2.0e3, "carcass_pressure_slope": 25e3}
ROVER_SIZE = {"radius": 0.125, "width": 0.16, "grouser_height": 0.006, "grouser_count": 30}
ROAD_TYRE = {"radius": 0.31, "width": 0.195}

WHEELS: dict[str, dict[str, Any]] = {
    "rigid_wheel_on_rigid_ground": {**ROVER_SIZE, "contact": {"model": "rigid_wheel_on_rigid_ground"}},
    "wheel_and_ground_in_series": {
        **ROVER_SIZE,
        "contact": {"model": "wheel_and_ground_in_series", "stiffness": 40e3},
    },
    "rigid_wheel_on_soil": {**ROVER_SIZE, "contact": {"model": "rigid_wheel_on_soil"}},
    "compliant_wheel_on_rigid_ground": {
        **LRV_SIZE,
        "contact": {"model": "compliant_wheel_on_rigid_ground", **LRV_MESH},
    },
    "compliant_wheel_on_soil": {
        **LRV_SIZE,
        "contact": {"model": "compliant_wheel_on_soil", **LRV_CARCASS},
    },
    "brush": {
        **ROVER_SIZE,
        "contact": {
            "model": "brush",
            "stiffness": 40e3,
            "longitudinal_stiffness": 1500.0,
            "cornering_stiffness": 1200.0,
        },
    },
    "bekker_wheel_on_soil": {**LRV_SIZE, "contact": {"model": "bekker_wheel_on_soil"}},
    "magic_formula": {**ROAD_TYRE, "contact": {"model": "magic_formula", "stiffness": 200e3}},
    "roller_wheel": {**ROVER_SIZE, "contact": {"model": "roller_wheel", "roller_angle_deg": 45.0}},
}
TRACK_SIZE = {"radius": 0.1, "width": 0.2}
TRACK = LevelTrackParams(model="track", length=0.9, road_wheels=5, peakedness=0.6)
FOOT_RADIUS = 0.12
LAWS = (*WHEELS, "track", "foot_pad")
"""All that there are examples of."""


def example_row(model: str, gravity: float = 1.62) -> FloatArray:
    """Row of the example of a law: (WHEEL_COLUMNS,)."""
    if model in WHEELS:
        wheel = WheelParams.model_validate({"name": "example", "joint": "joint", **WHEELS[model]})
        rows = wheel_rows([wheel], gravity)
        return rows.reshape(-1)
    row = np.zeros(WHEEL_COLUMNS)
    law: ContactLawParams = TRACK if model == "track" else FootPadParams(model="foot_pad")
    row[WheelColumn.RADIUS] = FOOT_RADIUS if model == "foot_pad" else TRACK_SIZE["radius"]
    row[WheelColumn.SHEAR_RADIUS] = row[WheelColumn.RADIUS]
    row[WheelColumn.WIDTH] = 0.0 if model == "foot_pad" else TRACK_SIZE["width"]
    row[WheelColumn.GRAVITY] = gravity
    row[WheelColumn.LAW] = row_entry(law.law())
    law.fill(row)
    return row
