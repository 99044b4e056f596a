// The choice of instruction sets, beside that of Highway's own library.
#include "parallel/simd_targets.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cstdint>

#ifdef __linux__
#include <dlfcn.h>
#endif

namespace cullhull::internal::simd_targets_test {

#if defined(__linux__) && defined(__x86_64__)
TEST(SimdTargets, AreThoseOfHighwaysLibrary) {
  void* const library = dlopen("libhwy.so.1", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) GTEST_SKIP() << "there is no libhwy.so.1";
  const auto theirs =
      reinterpret_cast<std::int64_t (*)()>(dlsym(library, "_ZN3hwy16SupportedTargetsEv"));
  ASSERT_NE(theirs, nullptr);
  // What later versions tell apart beyond this is compiled for on request only.
  const std::int64_t compared =
      HWY_SCALAR | HWY_EMU128 | HWY_SSSE3 | HWY_SSE4 | HWY_AVX2 | HWY_AVX3 | HWY_AVX3_DL;
  EXPECT_EQ(hwy::SupportedTargets() & compared, theirs() & compared);
}
#endif

TEST(SimdTargets, AreChosenAnewAfterTheyAreSet) {
  const std::int64_t supported = hwy::SupportedTargets();
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    EXPECT_EQ(hwy::SupportedTargets(), target);
    EXPECT_FALSE(hwy::GetChosenTarget().IsInitialized());
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    EXPECT_TRUE(hwy::GetChosenTarget().IsInitialized());
  }
  hwy::SetSupportedTargetsForTest(0);
  EXPECT_EQ(hwy::SupportedTargets(), supported);

  hwy::DisableTargets(supported);
  EXPECT_EQ(hwy::SupportedTargets(), HWY_STATIC_TARGET);
  hwy::DisableTargets(0);
  EXPECT_EQ(hwy::SupportedTargets(), supported);
}

}  // namespace cullhull::internal::simd_targets_test
