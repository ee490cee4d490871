"""Statics of a grasp: will an object slip, and how hard must the gripper press?

Fingers touch at points with friction (Murray, Li & Sastry 1994, A Mathematical Introduction to Robotic Manipulation,
ch. 5): the force at finger i is  f = R_i (t_1, t_2, n),  n >= 0,  |t| <= μ n, and a soft finger adds the moment m
about its normal, |m| <= γ n. The object rests if the forces and the load on it cancel:

    Σ f_i + w_force = 0,     Σ (p_i - c) × f_i + m_i + w_moment = 0

The round cone is replaced by a pyramid of `SIDES` edges inside it, so that the answer is on the safe side by at most
1 - cos(π/SIDES); with n <= the gripper's force it is a linear programme, solved by HiGHS (scipy).

Assumption: a rigid object at rest, fingers that can press as hard each as is asked for. The load is weight and inertia.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

SIDES = 32


class Finger(NamedTuple):
    """A finger's contact on the object."""

    place: FloatArray
    """(3,) [m]"""
    normal: FloatArray
    """Into the object, (3,), of any length."""
    friction: float
    """μ [-]"""
    torsion: float = 0.0
    """γ of a soft finger: moment about the normal over the force [m]."""


def needed_force(fingers: Sequence[Finger], centre: FloatArray, load: FloatArray) -> float:
    """Least pressing force that the strongest finger must have so that the object does not slip [N].

    Infinite where the object cannot be held by any force.

    Args:
        centre: about which moments are taken (3,) [m]. load: force and moment about it on the object (6,) [N], [N m].

    Raises:
        InvalidValueError: no finger, a normal without length, friction below zero, numbers not finite.
    """
    _check(fingers, centre, load)
    columns: list[FloatArray] = []
    presses: list[list[float]] = []
    for number, finger in enumerate(fingers):
        for ray, press in _rays(finger, centre):
            columns.append(ray)
            presses.append([press if place == number else 0.0 for place in range(len(fingers))])
    count = len(columns)
    # variables: weight of each ray, and the largest pressing force, which is made least
    cost = np.zeros(count + 1)
    cost[-1] = 1.0
    balance = np.column_stack([*columns, np.zeros(6)])
    limits = np.column_stack([np.array(presses).T, -np.ones(len(fingers))])
    scale = max(float(np.abs(load).max()), 1e-9)
    answer = linprog(cost, limits, np.zeros(len(fingers)), balance, -load / scale, method="highs")
    return float(answer.x[-1]) * scale if answer.status == 0 else math.inf


def holds(fingers: Sequence[Finger], centre: FloatArray, load: FloatArray, grasp_force: float) -> bool:
    """Whether the object stays where no finger presses with more than `grasp_force` [N]. Raises as `needed_force`."""
    return needed_force(fingers, centre, load) <= grasp_force


def _rays(finger: Finger, centre: FloatArray) -> list[tuple[FloatArray, float]]:
    """Edges of a finger's cone as wrenches (6,), each with the pressing force that is in it."""
    normal = finger.normal / np.linalg.norm(finger.normal)
    first = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)
    arm = finger.place - centre
    rays = []
    for angle in 2.0 * math.pi * np.arange(SIDES) / SIDES:
        force = normal + finger.friction * (math.cos(angle) * first + math.sin(angle) * second)
        rays.append((np.concatenate([force, np.cross(arm, force)]), 1.0))
    if finger.torsion > 0.0:
        for sense in (1.0, -1.0):
            moment = np.cross(arm, normal) + sense * finger.torsion * normal
            rays.append((np.concatenate([normal, moment]), 1.0))
    return rays


def _check(fingers: Sequence[Finger], centre: FloatArray, load: FloatArray) -> None:
    if not fingers:
        raise InvalidValueError("fingers", 0, "one or more")
    for finger in fingers:
        if not (np.isfinite(finger.place).all() and np.linalg.norm(finger.normal) > 1e-9):
            raise InvalidValueError("finger", (finger.place, finger.normal), "a finite place, a normal with a length")
        if not (finger.friction >= 0.0 and finger.torsion >= 0.0):
            raise InvalidValueError("friction of a finger", (finger.friction, finger.torsion), "0 or above")
    if centre.shape != (3,) or load.shape != (6,) or not np.isfinite([*centre, *load]).all():
        raise InvalidValueError("centre and load", (centre, load), "3 and 6 finite numbers")
