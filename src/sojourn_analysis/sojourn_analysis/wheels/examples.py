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
from sojourn_physics.contact.contact_law import WHEEL_COLUMNS, ContactModel, WheelColumn
from sojourn_physics.contact.foot_pad import FootPadParams
from sojourn_physics.contact.law_params import ContactLawParams
from sojourn_physics.contact.rows import kernel_rows
from sojourn_physics.contact.track import TrackParams

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

WHEELS: dict[ContactModel, dict[str, Any]] = {
    ContactModel.RIGID_WHEEL_ON_RIGID_GROUND: {**ROVER_SIZE, "contact": {"model": "rigid_wheel_on_rigid_ground"}},
    ContactModel.WHEEL_AND_GROUND_IN_SERIES: {
        **ROVER_SIZE,
        "contact": {"model": "wheel_and_ground_in_series", "stiffness": 40e3},
    },
    ContactModel.RIGID_WHEEL_ON_SOIL: {**ROVER_SIZE, "contact": {"model": "rigid_wheel_on_soil"}},
    ContactModel.COMPLIANT_WHEEL_ON_RIGID_GROUND: {
        **LRV_SIZE,
        "contact": {"model": "compliant_wheel_on_rigid_ground", **LRV_MESH},
    },
    ContactModel.COMPLIANT_WHEEL_ON_SOIL: {
        **LRV_SIZE,
        "contact": {"model": "compliant_wheel_on_soil", **LRV_CARCASS},
    },
    ContactModel.BRUSH: {
        **ROVER_SIZE,
        "contact": {
            "model": "brush",
            "stiffness": 40e3,
            "longitudinal_stiffness": 1500.0,
            "cornering_stiffness": 1200.0,
        },
    },
    ContactModel.BEKKER_WHEEL_ON_SOIL: {**LRV_SIZE, "contact": {"model": "bekker_wheel_on_soil"}},
    ContactModel.MAGIC_FORMULA: {**ROAD_TYRE, "contact": {"model": "magic_formula", "stiffness": 200e3}},
    ContactModel.ROLLER_WHEEL: {**ROVER_SIZE, "contact": {"model": "roller_wheel", "roller_angle_deg": 45.0}},
}
TRACK_SIZE = {"radius": 0.1, "width": 0.2}
TRACK = TrackParams(model="track", length=0.9, road_wheels=5, peakedness=0.6)
FOOT_RADIUS = 0.12


def example_row(model: ContactModel, gravity: float = 1.62) -> FloatArray:
    """Row of the example of a law: (WHEEL_COLUMNS,)."""
    if model in WHEELS:
        wheel = WheelParams.model_validate({"name": "example", "joint": "joint", **WHEELS[model]})
        rows = kernel_rows([wheel], [], gravity)
        return rows.reshape(-1)
    row = np.zeros(WHEEL_COLUMNS)
    law: ContactLawParams = TRACK if model is ContactModel.TRACK else FootPadParams(model="foot_pad")
    row[WheelColumn.RADIUS] = FOOT_RADIUS if model is ContactModel.FOOT_PAD else TRACK_SIZE["radius"]
    row[WheelColumn.SHEAR_RADIUS] = row[WheelColumn.RADIUS]
    row[WheelColumn.WIDTH] = 0.0 if model is ContactModel.FOOT_PAD else TRACK_SIZE["width"]
    row[WheelColumn.GRAVITY] = gravity
    row[WheelColumn.MODEL] = model
    law.fill(row)
    return row
