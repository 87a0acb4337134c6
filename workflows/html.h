// workflows/html.h -- pieces of an HTML page that an XML parser reads, too.
//
// Every function returns text that is safe to put into a page: what comes from users goes through
// escaped(), link() or base64() and through nothing else. Texts are UTF-8.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace sigmaflow::workflows::html {

/// For texts and for attributes in double quotes. Characters that XML 1.0 cannot hold become the
/// replacement mark U+FFFD.
std::string escaped(std::string_view text);

/// A path as a relative address: everything but letters, digits and - . _ ~ / is encoded.
std::string link(std::string_view path);

/// RFC 4648 with padding.
std::string base64(std::string_view bytes);

/// <name attributes>content</name>; `attributes` are complete: class="wide" id="x".
std::string element(std::string_view name, std::string_view content,
                    std::string_view attributes = "");

/// A table that scrolls on narrow screens; cells are HTML. No head: no line for it.
std::string table(const std::vector<std::string>& head,
                  const std::vector<std::vector<std::string>>& rows);

/// Opened by a click.
std::string details(std::string_view summary, std::string_view content,
                    std::string_view attributes = "");

/// A complete page with its style; nothing is loaded from elsewhere, there is no script.
std::string page(std::string_view title, std::string_view body);

}
