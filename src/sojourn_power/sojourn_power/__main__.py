"""python -m sojourn_power"""

from sojourn_power.node import main

main()
