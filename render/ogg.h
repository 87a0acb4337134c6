// render/ogg.h -- the pages of an Ogg stream (RFC 3533).
#pragma once
#include <cstdint>
#include <string>

namespace sigmaflow::render {

/// Gives the only stream of the file another number and its pages the checksums of that. Returns
/// whether the stream is complete: whole pages to the end, the last one marked as such.
bool renumber_stream(std::string& file, std::uint32_t number);

}
