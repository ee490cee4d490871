"""python -m sojourn_power"""

from sojourn_power.node import main

if __name__ == "__main__":
    main()
