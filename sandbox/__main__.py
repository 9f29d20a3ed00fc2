"""`python -m sandbox` is the `softcradle` command."""

import sys

from sandbox.cli import main

sys.exit(main())
