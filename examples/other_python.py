"""Debian's Python has numpy and matplotlib; another one on the PATH need not. Imported before they are."""
import importlib
import os
import sys

DEBIAN = "/usr/bin/python3"


def unless(*modules):
    """Goes on only if this Python has these modules; else Debian's begins the script anew."""
    try:
        for module in modules:
            importlib.import_module(module)
    except ImportError:
        if sys.executable == DEBIAN or not os.path.exists(DEBIAN):
            raise
        os.execv(DEBIAN, [DEBIAN] + sys.argv)
