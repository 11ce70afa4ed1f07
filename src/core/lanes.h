/// @file
/// Room `core`, private: four doubles at a time, or eight, for the loops that a step spends its time in.
///
/// Every lane does the same IEEE operations in the same order whatever the processor's vector width, so the bits do not
/// depend on the machine.
#pragma once

#include <cstddef>
#include <cstdint>

// Builds of a function for AVX-512 (x86-64-v4: 32 registers), for AVX2 and for any processor, of which one is chosen when the library
// is loaded. A test compiles their sources without the first and without any (TISSUE_CONTACT_NO_AVX512, _NO_CLONES) and compares the bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(TISSUE_CONTACT_NO_CLONES)
#if __GNUC__ >= 12 && !defined(TISSUE_CONTACT_NO_AVX512)
#define TISSUE_CONTACT_CLONES __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
// Of a function that works with WideLanes. Its own, since what a clone does with these would be taken apart before it is made.
#define TISSUE_CONTACT_WIDE __attribute__((noinline, target("arch=x86-64-v4")))
#else
#define TISSUE_CONTACT_CLONES __attribute__((target_clones("avx2", "default")))
#endif
#else
#define TISSUE_CONTACT_CLONES
#endif
#define TISSUE_CONTACT_ALWAYS_INLINE __attribute__((always_inline))
#define TISSUE_CONTACT_INLINE inline TISSUE_CONTACT_ALWAYS_INLINE

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

/// How many times four L holds.
template <typename L>
constexpr std::size_t kFours = sizeof(L) / sizeof(Lanes);

TISSUE_CONTACT_INLINE void join(const Lanes* fours, Lanes& to) { to = fours[0]; }
TISSUE_CONTACT_INLINE void split(const Lanes& from, Lanes* fours) { fours[0] = from; }
TISSUE_CONTACT_INLINE double sum(const Lanes& lanes) { return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]); }

#ifdef TISSUE_CONTACT_WIDE
/// Two fours at a time, for kernels that do for each four what Lanes do. Only functions that are built for AVX-512 have registers for it.
using WideLanes = double __attribute__((vector_size(2 * kLanes * sizeof(double))));

TISSUE_CONTACT_INLINE void join(const Lanes* fours, WideLanes& to) {
  to = __builtin_shufflevector(fours[0], fours[1], 0, 1, 2, 3, 4, 5, 6, 7);
}
TISSUE_CONTACT_INLINE void split(const WideLanes& from, Lanes* fours) {
  fours[0] = __builtin_shufflevector(from, from, 0, 1, 2, 3);
  fours[1] = __builtin_shufflevector(from, from, 4, 5, 6, 7);
}
TISSUE_CONTACT_INLINE double sum(const WideLanes& lanes) {
  Lanes fours[2];
  split(lanes, fours);
  return sum(fours[0] + fours[1]);
}

/// Processors with AVX-512 before Ice Lake, which lack VBMI2, lower their clock for 512-bit multiplications.
TISSUE_CONTACT_INLINE bool hasWideLanes() {
  return __builtin_cpu_supports("x86-64-v4") && __builtin_cpu_supports("avx512vbmi2");
}
#endif

}  // namespace tissue_contact
