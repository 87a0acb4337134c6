#include "tests/support/xml_tree.h"

#include <vtkSmartPointer.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLUtilities.h>

namespace sigmaflow::test {

namespace {

std::size_t collect(vtkXMLDataElement* element, XmlTree& tree)
{
    const std::size_t own = tree.elements.size();
    XmlElement& added = tree.elements.emplace_back();
    added.name = element->GetName();
    if (const char* text = element->GetCharacterData()) added.text = text;
    for (int i = 0; i < element->GetNumberOfAttributes(); ++i)
        added.attributes[element->GetAttributeName(i)] = element->GetAttributeValue(i);
    for (int i = 0; i < element->GetNumberOfNestedElements(); ++i) {
        const std::size_t child = collect(element->GetNestedElement(i), tree);
        tree.elements[own].children.push_back(child);
    }
    return own;
}

}

std::vector<XmlElement> XmlTree::named(const std::string& name) const
{
    std::vector<XmlElement> result;
    for (const XmlElement& element : elements)
        if (element.name == name) result.push_back(element);
    return result;
}

XmlTree read_xml(const std::string& text)
{
    XmlTree tree;
    const auto root = vtkSmartPointer<vtkXMLDataElement>::Take(
        vtkXMLUtilities::ReadElementFromString(text.c_str()));
    if (root) collect(root, tree);
    return tree;
}

}
