"""python -m sojourn_sensors"""

from sojourn_sensors.node import main

main()
