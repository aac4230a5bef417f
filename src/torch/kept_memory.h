// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace radar_dot {

/// From now on the large tensors of this process keep their memory for the next call of a network, which
/// asks for the same sizes again. RAFT's correlation volume alone is 52 MB at 640 x 360 px; given back to the
/// kernel and zeroed by it for every pair, it costs a third of the time. Once is enough; thread-safe.
void keepMemory();

}  // namespace radar_dot
