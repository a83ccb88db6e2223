# SPDX-License-Identifier: BSD-3-Clause
"""opcflow in KLayout: cells (shapes to a file), job (the process), results, window."""
