# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""What rosrun radar_dot report is made of: recording (bags), extraction, plots, film, page."""
