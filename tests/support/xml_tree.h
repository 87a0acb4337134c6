// Every element of an XML text in the order of the text, as an XML parser (expat, by VTK) reads it.
#pragma once
#include <map>
#include <string>
#include <vector>

namespace sigmaflow::test {

struct XmlElement {
    std::string name, text;  // text: directly in it
    std::map<std::string, std::string> attributes;
    std::vector<std::size_t> children;

    std::string attribute(const std::string& key) const
    {
        const auto it = attributes.find(key);
        return it == attributes.end() ? "" : it->second;
    }
};

struct XmlTree {
    std::vector<XmlElement> elements;  // the first one is the root; empty: not well-formed

    std::vector<XmlElement> named(const std::string& name) const;
};

XmlTree read_xml(const std::string& text);

}
