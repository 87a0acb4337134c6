// io/json_fields.h -- parameters declared once, used for reading, writing and explaining.
//
// A struct of parameters has one function `describe` with one line per field:
//
//   void describe(io::Fields& f)
//   {
//       f("volume_fraction", volume_fraction, io::above_to(0, 0.64), "-", "solid over box volume");
//       f("scheme", scheme, io::Words<Scheme>{{"heun", Scheme::heun}, ...}, "time stepping");
//   }
//
// Name, allowed values, unit and meaning stand in that line, the default is the value that the
// struct has when it is described. From the list of fields come the strict reader (read_fields),
// the resolved parameters of a manifest (write_fields), the help texts (Field::allowed,
// default_text) and the JSON Schema (io/json_schema.h).
#pragma once
#include "io/json_document.h"

#include <functional>
#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sigmaflow::io {

enum class FieldKind {
    number,
    integer,
    boolean,
    text,
    word,
    vector,
    numbers,
    texts,
    objects,
    group,
    sweep
};

/// One parameter. It refers to the struct that was described, which must live as long.
struct Field {
    std::string name = {}, unit = {}, help = {};
    FieldKind kind = FieldKind::number;
    Range range = {};                          // of numbers and integers
    Length length = {};                        // bytes of a text or of each of the texts
    Length elements = {};                      // of numbers and texts
    std::string pattern = {};                  // regular expression for a text, if it has a form
    std::vector<std::string_view> words = {};  // of a word
    std::vector<Field> members = {};           // of a group
    bool required = false;                     // must be given
    bool names_file = false;                   // a text: a path relative to the folder of the file
    std::function<void(const JsonNode&)> read = {};
    std::function<nlohmann::ordered_json()> write = {};  // null: not given and without a default

    Field& require()
    {
        required = true;
        return *this;
    }
    Field& of_file()
    {
        names_file = true;
        return *this;
    }
    /// "> 0 and <= 0.64", "heun, euler", "true, false"
    std::string allowed() const;
    /// The default as JSON text, "required" or "none".
    std::string default_text() const;
};

/// The words of an enumeration in the order in which they are explained.
template <class Enum>
using Words = std::vector<std::pair<std::string_view, Enum>>;

/// Allowed integers, ends included.
struct Integers {
    std::int64_t low, high;
};

class Fields {
public:
    Field& operator()(std::string name, double& value, Range range, std::string unit,
                      std::string help);
    Field& operator()(std::string name, std::optional<double>& value, Range range, std::string unit,
                      std::string help);
    Field& operator()(std::string name, int& value, Integers range, std::string unit,
                      std::string help);
    Field& operator()(std::string name, std::optional<int>& value, Integers range, std::string unit,
                      std::string help);
    Field& operator()(std::string name, std::uint64_t& value, std::string help);
    Field& operator()(std::string name, std::optional<std::uint64_t>& value, std::string help);
    Field& operator()(std::string name, bool& value, std::string help);
    /// A text of at most `longest` bytes.
    Field& operator()(std::string name, std::string& value, std::size_t longest, std::string help);
    /// One of a list of words that is kept as a text.
    Field& operator()(std::string name, std::string& value, std::vector<std::string_view> words,
                      std::string help);
    Field& operator()(std::string name, Vec3& value, Range range, std::string unit,
                      std::string help);
    Field& operator()(std::string name, std::vector<double>& value, Length length, Range range,
                      std::string unit, std::string help);
    /// Texts of at most `longest` bytes.
    Field& operator()(std::string name, std::vector<std::string>& value, Length length,
                      std::size_t longest, std::string help);

    template <class Enum>
    Field& operator()(std::string name, Enum& value, Words<Enum> words, std::string help);

    /// An object of its own; `describe` is called at once.
    Field& group(std::string name, std::string help, const std::function<void(Fields&)>& describe);

    /// An object that replaces some of the described values: those that were given, as JSON.
    Field& changes(std::string name, std::string help, const std::function<void(Fields&)>& describe,
                   nlohmann::ordered_json& given);

    /// A field with functions of its own.
    Field& add(Field field);

    const std::vector<Field>& list() const { return fields_; }

private:
    Field& add_word(std::string name, std::vector<std::string_view> words, std::string help,
                    std::function<std::size_t()> get, std::function<void(std::size_t)> set);
    std::vector<Field> fields_;
};

/// Fills the described struct from an object. Unknown keys, missing required ones and wrong values
/// are errors (input) with file, line, column and pointer; all of them are thrown at once (Errors).
/// Wrong values are not taken: the struct keeps what it had.
void read_fields(const JsonNode& object, const std::vector<Field>& fields);

/// The described struct as JSON; fields without a value are left out.
nlohmann::ordered_json write_fields(const std::vector<Field>& fields);

template <class Enum>
Field& Fields::operator()(std::string name, Enum& value, Words<Enum> words, std::string help)
{
    std::vector<std::string_view> allowed;
    for (const auto& word : words) allowed.push_back(word.first);
    const auto get = [&value, words] {
        std::size_t index = 0;
        while (index + 1 < words.size() && words[index].second != value) ++index;
        return index;
    };
    const auto set = [&value, words](std::size_t index) { value = words[index].second; };
    return add_word(std::move(name), std::move(allowed), std::move(help), get, set);
}

}
