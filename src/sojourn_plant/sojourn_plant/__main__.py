"""python -m sojourn_plant"""

from sojourn_plant.node import main

main()
