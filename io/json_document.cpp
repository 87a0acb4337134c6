#include "io/json_document.h"

#include "io/atomic_file.h"
#include "io/json_override.h"
#include "io/json_parse.h"

namespace sigmaflow::io {

JsonDocument JsonDocument::read(const std::filesystem::path& path,
                                const std::vector<Override>& overrides)
{
    return parse(read_file(path, largest_json_file), path.string(), overrides);
}

JsonDocument JsonDocument::parse(std::string text, std::string name,
                                 const std::vector<Override>& overrides)
{
    auto tree = std::make_shared<JsonTree>();
    tree->name = std::move(name);
    tree->text = std::move(text);
    parse_json(*tree);
    for (const Override& given : overrides) apply_override(*tree, given);
    return JsonDocument(std::move(tree));
}

JsonNode JsonDocument::root() const&
{
    return JsonNode(tree_.get(), &tree_->root, "");
}

const std::string& JsonDocument::text() const
{
    return tree_->text;
}

}
