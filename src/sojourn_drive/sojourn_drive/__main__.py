"""python -m sojourn_drive"""

from sojourn_drive.node import main

main()
