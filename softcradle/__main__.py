"""`python -m softcradle` is the `softcradle` command."""

import sys

from softcradle.sandbox.cli.main import main

sys.exit(main())
