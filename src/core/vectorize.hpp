#pragma once

/// Marks a function with a hot loop: compiled for wide vector units as well, the best one is picked when the program
/// starts. Every version rounds alike, since no contraction or reassociation is allowed.
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SHAPELIGHT_VECTORIZE __attribute__((target_clones("avx2", "default")))
#else
#define SHAPELIGHT_VECTORIZE
#endif
