"""Parameters of a soil (or a rigid rock), as the wheel and pad contact laws use them.

Pressure under a plate of width b sunk by z, in the form that the file names:

    bekker   p = (k_c / b + k_phi) z^n        (Bekker 1969, Introduction to Terrain-Vehicle Systems, ch. 1)
    reece    p = (k_c + b k_phi) (z / b)^n    (Wong & Reece 1967, J. Terramechanics 4(1):81, eq. 1;
                                               there k_c stands for c k_c' and k_phi for gamma k_phi')

Shear stress after a shear displacement j (Janosi & Hanamoto 1961): tau = (c + p tan phi)(1 - exp(-j / K)).
The modulus K may grow with the slip angle beta of the wheel, K = K_0 + K_1 |beta| (Ishigami et al. 2007,
J. Field Robotics 24(3):233, table 2); K_1 is zero where nobody has measured it.

Unloading and reloading follow a line of the stiffness k_0 + A_u z_u (`repeated_loading`).

Angle of greatest normal stress under a rigid wheel (Wong & Reece 1967): theta_m = (c1 + c2 s) theta_1.
Exit angle: `zero` (the contact ends under the axle), or `lambda:L`: theta_2 = -acos(1 - L h / r), where L is
the height of the rut behind the wheel over the sinkage h (Ishigami et al. 2007); L > 1 is soil that is
carried up behind the wheel.

Terms beyond Wong and Reece's, each off unless a soil gives it (`wheel_on_soil` has the equations): friction and
adhesion of the soil on a bare rim, peak and residual shear stress (Wong 2008, sec. 2.4.3), growth of the sinkage with
slip, skid and sideslip, growth of theta_m with the sideslip, and soil pushed by the front and by the side of a wheel.

Normal damping is of the Hunt-Crossley kind (Hunt & Crossley 1975, J. Appl. Mech. 42:440): p (1 + d dz/dt), d
in s/m. No soil table gives d: it is an estimate in every file. Rigid rock is the same law with n = 1, no
cohesion and a stiff k_phi.

Range of validity: homogeneous ground, widths from about 0.03 to 0.5 m, sinkage below the wheel's radius.
"""

import math
from collections.abc import Sequence
from enum import IntEnum
from typing import Any, Literal, NamedTuple, Self

import numpy as np
from pydantic import Field, field_validator, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray, Params
from sojourn_physics.soil.bearing import MAX_FRICTION_ANGLE, failure_strength
from sojourn_physics.soil.relative_density import density_at
from sojourn_physics.soil.shear import hump_coefficients
from sojourn_physics.soil.spread import check_spread

MAX_EXIT_LAMBDA = 2.0
EXIT_LAMBDA_ZERO = -1.0
"""Value of the column `exit_lambda` for exit angle `zero`."""

LETE_SAND_A_U = 503.0e6
"""A_u of LETE sand, with k_0 = 0 (Wong 1989, Terramechanics and Off-Road Vehicles, ch. 4): stands in where a soil's own
unloading has not been measured [N/m^4]."""

MAX_LEAST_WIDTH = 0.5
"""Greatest width at which a negative k_c may leave no stiffness: that of the widest wheels [m]."""

SOIL_ONLY = ("cohesion", "shear_modulus", "shear_modulus_lateral", "density", "theta_m_c1", "theta_m_c2")
"""Fields that rigid ground may leave out: what shears and flows has them. Their defaults stand for no soil at all."""

FORM_BEKKER = 0.0
FORM_REECE = 1.0


def parse_exit_angle(text: str) -> float | None:
    """Read `zero` (gives None) or `lambda:L` (gives L).

    Raises:
        InvalidValueError: any other text, or an L outside 0 to 2.
    """
    allowed = f"'zero' or 'lambda:L' with L from 0 to {MAX_EXIT_LAMBDA:g}"
    if text == "zero":
        return None
    prefix, separator, number = text.partition(":")
    if prefix != "lambda" or not separator:
        raise InvalidValueError("exit_angle", text, allowed)
    try:
        value = float(number)
    except ValueError as error:
        raise InvalidValueError("exit_angle", text, allowed) from error
    if not 0.0 <= value <= MAX_EXIT_LAMBDA:
        raise InvalidValueError("exit_angle", text, allowed)
    return value


class SoilParams(Params):
    """One soil. The field names are the keys of the files in `config/soils`."""

    name: str = Field(min_length=1, pattern=r"^[a-z][a-z0-9_]*$", description="name of the soil, as its file")
    citation: str = Field(min_length=1, description="where the numbers are from")
    estimates: tuple[str, ...] = Field(
        default=("contact_damping",), description="fields of this set that no source gives: estimates of ours"
    )
    kind: Literal["soil", "rigid"] = Field(default="soil", description="soil, or rock that does not yield")
    form: Literal["bekker", "reece"] = Field(default="bekker", description="form of the pressure-sinkage law")
    n: float = Field(gt=0.0, le=3.0, description="sinkage exponent [-]")
    k_c: float = Field(
        ge=-1e9,
        le=1e9,
        description="cohesive modulus [bekker: N/m^(n+1), reece: N/m^2]; negative in some fits",
    )
    k_phi: float = Field(ge=0.0, le=1e11, description="frictional modulus [bekker: N/m^(n+2), reece: N/m^3]")
    cohesion: float = Field(default=0.0, ge=0.0, le=1e6, description="cohesion [Pa]")
    friction_angle_deg: float = Field(ge=0.0, lt=80.0, description="angle of internal friction [degree]")
    shear_modulus: float = Field(default=5e-4, gt=0.0, le=1.0, description="Janosi K along the wheel [m]")
    shear_modulus_lateral: float = Field(default=5e-4, gt=0.0, le=1.0, description="Janosi K across the wheel [m]")
    shear_modulus_per_slip_angle: float = Field(
        default=0.0, ge=0.0, le=1.0, description="growth of shear_modulus with the slip angle [m/rad]"
    )
    shear_modulus_lateral_per_slip_angle: float = Field(
        default=0.0, ge=0.0, le=1.0, description="growth of shear_modulus_lateral with the slip angle [m/rad]"
    )
    unloading_stiffness: float = Field(
        default=0.0, ge=0.0, le=1e12, description="k_0 of the unloading stiffness k_0 + A_u z_u [N/m^3]"
    )
    unloading_stiffness_per_sinkage: float = Field(
        default=LETE_SAND_A_U, ge=0.0, le=1e14, description="A_u of the unloading stiffness k_0 + A_u z_u [N/m^4]"
    )
    compacted_share: float = Field(
        default=1.0, ge=0.0, le=1.0, description="of soil that is pressed down; the rest is found beside the rut [-]"
    )
    density: float = Field(
        default=3000.0, gt=0.0, le=10000.0, description="bulk density [kg/m3]; or relative_density instead"
    )
    density_range: tuple[float, float] | None = Field(default=None, description="loosest and densest state [kg/m3]")
    relative_density: float | None = Field(
        default=None, ge=0.0, le=1.0, description="0 loosest, 1 densest; gives the density, within density_range"
    )
    theta_m_c1: float = Field(default=0.0, ge=0.0, le=1.0, description="c1 of theta_m = (c1 + c2 s) theta_1 [-]")
    theta_m_c2: float = Field(default=0.0, ge=-1.0, le=1.0, description="c2 of theta_m = (c1 + c2 s) theta_1 [-]")
    exit_angle: str = Field(default="zero", description="'zero' or 'lambda:L', L = rut height / sinkage [-]")
    theta_m_c3: float = Field(default=0.0, ge=-1.0, le=1.0, description="c3 of theta_m, growth with the sideslip [-]")
    contact_damping: float = Field(ge=0.0, le=100.0, description="Hunt-Crossley normal damping d [s/m]")
    interface_friction_angle_deg: float | None = Field(
        default=None, ge=0.0, lt=80.0, description="friction of the soil on a bare rim [degree]; none: as in the soil"
    )
    interface_adhesion: float = Field(
        default=0.0, ge=0.0, le=1e6, description="adhesion on a bare rim, where the friction on it is given [Pa]"
    )
    residual_shear_ratio: float | None = Field(
        default=None, gt=0.0, le=1.0, description="residual over peak shear stress, the peak at j = K [-]; none: Janosi"
    )
    slip_sinkage: float = Field(default=0.0, ge=0.0, le=20.0, description="growth of the sinkage with slip [-]")
    skid_sinkage: float = Field(default=0.0, ge=0.0, le=20.0, description="growth with the square of the skid [-]")
    side_sinkage: float = Field(default=0.0, ge=0.0, le=20.0, description="growth with the sideslip [-]")
    front_bulldozing: bool = Field(default=False, description="whether soil pushed ahead of a wheel resists")
    side_bulldozing: bool = Field(default=False, description="whether soil pushed by the side of a wheel resists")
    bulldozing_failure: Literal["general", "local"] = Field(
        default="general", description="general shear failure (dense soil) or local (loose: 2/3 of c and tan phi)"
    )
    specific_energy: float | None = Field(
        default=None, gt=0.0, le=1e11, description="intrinsic specific energy of drilling [J/m3], see soil/drilling.py"
    )
    bulldozing_modulus: float = Field(
        default=0.02, gt=0.0, le=1.0, description="displacement that mobilises the push on the side [m]"
    )
    spread: dict[str, float | tuple[float, float]] = Field(
        default={}, description="uncertainty of fields: a standard deviation, or a lowest and highest value"
    )

    @field_validator("exit_angle")
    @classmethod
    def _exit_angle_is_readable(cls, text: str) -> str:
        parse_exit_angle(text)
        return text

    @model_validator(mode="after")
    def _density_or_relative_density(self) -> Self:
        if self.relative_density is not None:
            if self.density_range is None:
                raise InvalidValueError("density_range", None, "[loosest, densest] where a relative_density is given")
            # the model is frozen for everybody else
            self.__dict__["density"] = density_at(self.relative_density, *self.density_range)
        return self

    @model_validator(mode="after")
    def _soil_is_complete(self) -> Self:
        missing = self.missing(SOIL_ONLY) if self.kind == "soil" else ()
        if missing:
            raise InvalidValueError(
                "kind", self.kind, "rigid, or soil with all of its keys; missing: " + ", ".join(missing)
            )
        return self

    def missing(self, fields: Sequence[str]) -> tuple[str, ...]:
        """Those of the fields that this set does not give, in their order."""
        given = self.model_fields_set | ({"density"} if self.relative_density is not None else set())
        return tuple(name for name in fields if name not in given)

    @model_validator(mode="after")
    def _stiffness_and_estimates(self) -> Self:
        if self.k_c <= 0.0 and self.k_phi <= 0.0:
            allowed = f"more than 0 where k_c = {self.k_c:g} is not positive"
            raise InvalidValueError("k_phi", self.k_phi, allowed)
        if self.least_width > MAX_LEAST_WIDTH:
            raise InvalidValueError(
                "k_c", self.k_c, f"at least -{MAX_LEAST_WIDTH:g} m times k_phi: below it the soil carries no wheel"
            )
        if self.friction_angle > MAX_FRICTION_ANGLE and (self.front_bulldozing or self.side_bulldozing):
            raise InvalidValueError(
                "friction_angle_deg", self.friction_angle_deg, "at most 60 for a soil that is pushed"
            )
        largest = self.theta_m_c1 + self.theta_m_c2
        if largest > 1.0:
            raise InvalidValueError("theta_m_c1 + theta_m_c2", largest, "at most 1: theta_m is below theta_1")
        check_spread(type(self).model_fields, self.spread)
        unknown = sorted(set(self.estimates) - set(type(self).model_fields))
        if unknown:
            raise InvalidValueError("estimates", unknown, "names of fields of a soil")
        return self

    @property
    def exit_lambda(self) -> float | None:
        """Rut height behind the wheel over the sinkage [-], or None where the contact ends under the axle."""
        return parse_exit_angle(self.exit_angle)

    @property
    def least_width(self) -> float:
        """Width of a plate at which the stiffness k_c + b k_phi is zero [m]: a negative k_c holds for wider ones."""
        return max(0.0, -self.k_c / self.k_phi) if self.k_phi > 0.0 else 0.0

    @property
    def friction_angle(self) -> float:
        """Angle of internal friction [rad]."""
        return math.radians(self.friction_angle_deg)

    def unit_weight(self, gravity: float) -> float:
        """Weight of a cubic metre [N/m3] where the gravity is `gravity` [m/s2].

        Raises:
            InvalidValueError: gravity that is negative or not finite.
        """
        if not (math.isfinite(gravity) and gravity >= 0.0):
            raise InvalidValueError("gravity", gravity, "a finite number, at least 0 m/s2")
        return self.density * gravity


class Derived(NamedTuple):
    """Columns of a kernel row that are not fields of a soil as they stand."""

    form: float
    tan_phi: float
    exit_lambda: float
    unloading_stiffness: float
    unloading_stiffness_per_sinkage: float
    interface_tan_phi: float
    interface_adhesion: float
    residual: float
    hump: float
    bulldozing_cohesion: float
    bulldozing_tan_phi: float
    bulldozing_k_c: float
    bulldozing_k_gamma: float


def _derived(soil: SoilParams) -> Derived:
    tan_phi = math.tan(soil.friction_angle)
    # rock springs back along the line that it was loaded on, and keeps no rut
    yields = soil.kind == "soil"
    bare = soil.interface_friction_angle_deg
    residual, hump = hump_coefficients(soil.residual_shear_ratio)
    failing = failure_strength(soil.cohesion, soil.friction_angle, soil.bulldozing_failure == "local")
    return Derived(
        form=FORM_BEKKER if soil.form == "bekker" else FORM_REECE,
        tan_phi=tan_phi,
        exit_lambda=EXIT_LAMBDA_ZERO if soil.exit_lambda is None else soil.exit_lambda,
        unloading_stiffness=soil.unloading_stiffness if yields else 0.0,
        unloading_stiffness_per_sinkage=soil.unloading_stiffness_per_sinkage if yields else 0.0,
        # a soil weaker than its interface shears in itself
        interface_tan_phi=tan_phi if bare is None else min(math.tan(math.radians(bare)), tan_phi),
        interface_adhesion=soil.cohesion if bare is None else min(soil.interface_adhesion, soil.cohesion),
        residual=residual,
        hump=hump,
        bulldozing_cohesion=failing.cohesion,
        bulldozing_tan_phi=math.tan(failing.friction_angle),
        bulldozing_k_c=failing.factors.k_c,
        bulldozing_k_gamma=failing.factors.k_gamma,
    )


NUMBERS = tuple(name for name, field in SoilParams.model_fields.items() if field.annotation in (float, bool))
"""Fields of a soil that the kernels get as they are."""
SOIL_COLUMNS: tuple[str, ...] = tuple(dict.fromkeys((*NUMBERS, *Derived._fields)))
"""Names of the columns of a kernel row, in order."""


def _columns(names: Sequence[str]) -> Any:
    """Numbers from 0 on, by name: of a type that no checker knows, since the names are those of a soil's fields."""
    return IntEnum("SoilColumn", [name.upper() for name in names], start=0, module=__name__)


SoilColumn = _columns(SOIL_COLUMNS)
"""Columns of a kernel row, by name: a new field of a soil is one, and needs no other line."""


def kernel_row(params: SoilParams) -> FloatArray:
    """Numbers of one soil for the contact kernels: shape (len(SOIL_COLUMNS),), contiguous, all finite."""
    values = {name: float(getattr(params, name)) for name in NUMBERS} | _derived(params)._asdict()
    return np.array([values[name] for name in SOIL_COLUMNS], dtype=np.float64)


def kernel_table(soils: Sequence[SoilParams]) -> FloatArray:
    """Kernel rows of several soils in their order: shape (len(soils), len(SOIL_COLUMNS)), contiguous.

    Row i belongs to index i of a height field's `soil_index` if `soils` is in the order of its `soil_names`.

    Raises:
        InvalidValueError: no soil at all.
    """
    if not soils:
        raise InvalidValueError("soils", [], "at least one soil")
    return np.ascontiguousarray(np.stack([kernel_row(soil) for soil in soils]))
