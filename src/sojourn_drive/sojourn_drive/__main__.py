"""python -m sojourn_drive"""

from sojourn_drive.node import main

if __name__ == "__main__":
    main()
