"""python -m sojourn_arm"""

from sojourn_arm.node import main

if __name__ == "__main__":
    main()
