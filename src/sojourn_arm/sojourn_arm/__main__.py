"""python -m sojourn_arm"""

from sojourn_arm.node import main

main()
