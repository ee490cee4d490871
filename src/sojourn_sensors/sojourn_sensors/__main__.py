"""python -m sojourn_sensors"""

from sojourn_sensors.node import main

if __name__ == "__main__":
    main()
