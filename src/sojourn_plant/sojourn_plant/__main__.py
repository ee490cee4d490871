"""python -m sojourn_plant"""

from sojourn_plant.node import main

if __name__ == "__main__":
    main()
