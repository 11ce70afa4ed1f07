/// @file
/// Room `core`, private: four doubles at a time, for the loops that a step spends its time in.
///
/// Every lane does the same IEEE operations in the same order whatever the processor's vector width, so the bits do not
/// depend on the machine.
#pragma once

#include <cstdint>

// One build of a function for AVX2 and one for any processor, chosen when the library is loaded. A test compiles their sources
// without (TISSUE_CONTACT_NO_CLONES) and compares the bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(TISSUE_CONTACT_NO_CLONES)
#define TISSUE_CONTACT_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define TISSUE_CONTACT_CLONES
#endif
#define TISSUE_CONTACT_INLINE inline __attribute__((always_inline))

namespace tissue_contact {

constexpr int kLanes = 4;

using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));
using LanePlaces = std::int64_t __attribute__((vector_size(kLanes * sizeof(std::int64_t))));

// Lanes i, j, k, l of the eight of a and b: one or two instructions, where lanes put together one by one are five.
#if defined(__clang__)
#define TISSUE_CONTACT_SHUFFLE(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, k, l)
#else
#define TISSUE_CONTACT_SHUFFLE(a, b, i, j, k, l) __builtin_shuffle(a, b, LanePlaces{i, j, k, l})
#endif

}  // namespace tissue_contact
