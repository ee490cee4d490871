#!/usr/bin/env python3
"""Starts a scenario: scripts/start.py SCENARIO [options]. See scripts/start.py --help."""

import os
import sys

launcher = os.path.join(os.path.dirname(os.path.realpath(__file__)), "lib", "python")
os.execv(launcher, [launcher, "-m", "sojourn_bringup.start", *sys.argv[1:]])
