"""What does not change of a scene, and the scene of a moment: ground, light and machine, ready to be rendered.

What is kept between images, walks and shadows, is a function of the scene alone: it saves time and changes no number.
"""

import math
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from threading import Lock
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sojourn_machine.params import FloatArray
from sojourn_machine.shapes import ALBEDO, Shapes
from sojourn_physics.imaging.camera import Optics
from sojourn_physics.imaging.echoes import Sounded, echoes
from sojourn_physics.imaging.ground import DrawnGround, seen_ground, with_changes
from sojourn_physics.imaging.lighting import PlacedLens, Scene
from sojourn_physics.imaging.photometry import Illumination, Look
from sojourn_physics.imaging.ranging import Beams
from sojourn_physics.imaging.render import render
from sojourn_physics.imaging.shadows import CastShadows, shadows
from sojourn_physics.imaging.soils import Soils, soils_of
from sojourn_physics.imaging.texture import grain
from sojourn_physics.imaging.touch import way_ahead
from sojourn_physics.imaging.walks import Eye, WalkRoom, panorama
from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.memory import GroundMemory

Seen: TypeAlias = tuple[NDArray[np.float32], NDArray[np.float32]]
"""Radiance [W/m2/sr] and distance [m], infinite for the sky, of each pixel, (rows, columns)."""
BIN = 1.2
"""Bins of a panorama, in pixels [-]."""
SLOPE, CONTRAST = 0.05, 0.04
"""Of the grain, for each octave: estimates that look like the pictures of Surveyor and the Mars Exploration Rovers."""
SOUND = -1
"""Of the walks of what needs no light; those of cameras that look at once have numbers from 0 on."""
FARTHEST = 5000.0
"""Ground that is looked for at most [m]."""


@dataclass(frozen=True, eq=False, slots=True)
class GroundLook:
    """Where all of it is: what a body's ground looks like."""

    albedo: float
    """Of the soil that is everywhere [-]."""
    airless: bool
    radius: float
    """Of the body, infinite for none [m]."""
    brightness: tuple[float, ...]
    """Of each soil of the height field, of the albedo [-]."""


@dataclass(frozen=True, eq=False, slots=True)
class Moment:
    """What changes."""

    sun: FloatArray
    """Unit vector to the Sun in map and the angular radius of its disc [rad], (4,)."""
    light: Illumination
    memory: GroundMemory
    """What wheels and tools have done to the ground."""
    body: Shapes
    """The machine's shapes in map."""


def in_turn(calls: Sequence[Callable[[], Seen]]) -> list[Seen]:
    """What calls return that are made one after another."""
    return [call() for call in calls]


class Scenery:
    """The ground of a scenario, as cameras see it.

    More than one thread may ask: who looks waits for who looks, who sounds for who sounds.
    """

    def __init__(self, field: HeightField, place: GroundLook) -> None:
        self._ground = seen_ground(field)
        self._last: tuple[GroundMemory | None, DrawnGround] = (None, self._ground)
        self._place = place
        self._soils = soils_of(field, place.brightness)
        self._grain = grain(SLOPE, CONTRAST, field.resolution)
        self._look = Look(place.albedo, 1.0 if place.airless else 0.0)
        self._shadows = lru_cache(maxsize=4)(self._shadows_of)
        self._ways = defaultdict[int, WalkRoom](WalkRoom)
        self._looking, self._sounding = Lock(), Lock()
        """Of what is kept for either."""

    def see(
        self,
        eye: Optics,
        moment: Moment,
        turn: FloatArray,
        places: Sequence[FloatArray],
        all_of: Callable[[Sequence[Callable[[], Seen]]], list[Seen]] = in_turn,
    ) -> list[Seen]:
        """What cameras that are turned alike see of a moment.

        Args:
            turn: from the optical frame into map, (3, 3). places: of the cameras in map, each (3,) [m].
            all_of: makes calls that share nothing, and returns what they do in their order.
        """
        rises = np.einsum("k,kij->ij", turn[2].astype(np.float32), eye.directions)
        lowest, highest = float(rises.min()), float(rises.max())
        view = PlacedLens(eye.directions, np.ascontiguousarray(turn), eye.pixel)

        def looking_from(number: int) -> Callable[[], Seen]:
            at = Eye(np.array(places[number], dtype=np.float64), FARTHEST, 0.5 / self._place.radius)
            around = panorama(BIN * eye.pixel, lowest, highest, self._ways[number])
            scene = self._scene(moment, number)
            return lambda: render(scene, view, at, around)

        with self._looking:
            return all_of([looking_from(number) for number in range(len(places))])

    def sound(
        self, beams: Beams, memory: GroundMemory, body: Shapes, turn: FloatArray, place: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Distance along each beam [m] and what returns of it [-], as `echoes.echoes`; it needs no light.

        Args:
            memory, body: see `Moment`. turn: from the beams' frame into map, (3, 3). place: in map, (3,) [m].
        """
        rays = np.ascontiguousarray(beams.directions @ turn.T)
        eye = Eye(np.array(place, dtype=np.float64), min(beams.reach, FARTHEST), 0.5 / self._place.radius)
        with self._sounding:
            around = panorama(beams.spacing, float(rays[:, 2].min()), float(rays[:, 2].max()), self._ways[SOUND])
            met = Sounded(self._now(memory), self._soils, self._place.albedo, body)
            if beams.reflectance is not None:
                met = _as_bright(met, beams.reflectance)
            found: tuple[FloatArray, FloatArray] = echoes(met, rays, eye, around)
        return found

    @property
    def node(self) -> float:
        """Distance of the ground's nodes [m]."""
        return float(self._ground.place[3])

    def way_ahead(self, places: FloatArray, ahead: FloatArray, memory: GroundMemory, farthest: float) -> float:
        """Shortest way to the ground [m], as `touch.way_ahead`."""
        return float(way_ahead(self._now(memory), np.ascontiguousarray(places), np.array(ahead), farthest))

    def _scene(self, moment: Moment, number: int) -> Scene:
        """Of a moment, for one of the cameras that look at once."""
        return Scene(
            self._now(moment.memory),
            self._soils,
            self._look,
            self._grain,
            moment.light,
            self._shadows(number, *(float(part) for part in moment.sun)),
            moment.body,
        )

    def _now(self, memory: GroundMemory) -> DrawnGround:
        last = self._last
        if last[0] is not memory:
            self._last = last = memory, with_changes(self._ground, memory)
        return last[1]

    def _shadows_of(self, number: int, x: float, y: float, z: float, disc: float) -> CastShadows:
        """Each of the cameras that look at once fills in its own, so that none reads what another has half written."""
        return shadows(self._ground, np.array([x, y, z, disc]))


def _as_bright(met: Sounded, reflectance: float) -> Sounded:
    """The same where all has one reflectance [-]."""
    sizes = met.body.sizes.copy()
    sizes[:, ALBEDO] = reflectance
    soils = Soils(met.soils.of_node[:1, :1], met.soils.place, np.ones_like(met.soils.brightness))
    return Sounded(met.ground, soils, reflectance, met.body._replace(sizes=sizes))


def sun_of(direction: FloatArray, radius: float) -> FloatArray:
    """`Moment.sun` of a unit vector, (3,), and a disc's angular radius [rad]."""
    return np.array([*direction, min(max(radius, 1e-4), 0.5 * math.pi)])
