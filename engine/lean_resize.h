// engine/lean_resize.h -- vectors that are filled anew grow by an eighth, not to the double.
#pragma once
#include <cstddef>
#include <vector>

namespace sigmaflow {

/// v gets `count` elements of any value.
template <class T>
void lean_resize(std::vector<T>& v, std::size_t count)
{
    if (count > v.capacity()) {
        v = {};  // the old memory first
        v.reserve(count + count / 8);
    }
    v.resize(count);
}

}
