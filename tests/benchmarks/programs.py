# SPDX-License-Identifier: Apache-2.0
"""Where the programs and the bundled meshes are, and how the protocols run them."""
import os
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BIN = os.path.join(ROOT, "build/release/bin")
MESHES = os.path.join(ROOT, "data/meshes")


def run(command, **options):
    """Runs a program; its standard output. Ends with a clear line where it fails."""
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, text=True, **options)
    if done.returncode != 0:
        sys.exit(f"bench: {' '.join(str(c) for c in command)} ended with {done.returncode}")
    return done.stdout


def newer(program, product):
    """Whether a product is missing or older than the program that makes it."""
    return not os.path.exists(product) or os.path.getmtime(program) > os.path.getmtime(product)
