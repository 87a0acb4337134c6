// tests/support/sanitized.h -- is this a build with the address sanitizer, which takes time and
// memory of its own and ends programs in its own way?
#pragma once

namespace sigmaflow {

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool sanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif
#else
inline constexpr bool sanitized = false;
#endif

}
