// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// The loops over pixels exist twice, for processors with and without AVX2; the processor at hand chooses.
// Both round alike. Sanitizers start later than that choice.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define RADAR_DOT_VECTORISED __attribute__((target_clones("avx2", "default")))
#else
#define RADAR_DOT_VECTORISED
#endif
