"""`python -m sojourn_bags`: the recorder."""

from sojourn_bags.recorder_node import main

if __name__ == "__main__":
    main()
