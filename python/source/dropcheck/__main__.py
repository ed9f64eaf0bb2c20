"""`python -m dropcheck`: the command."""

import sys

from . import main

sys.exit(main())
