// engine/error.h -- the one exception type of sigmaflow.
//
// An Error says what kind of failure it is (the kind is also the exit code of the program), where
// it happened, and what is wrong with the value and the limit. Layers add context while the
// exception unwinds, innermost last: `error.within("/steps/2")`. Messages are lower case without a
// full stop.
#pragma once
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace sigmaflow {

enum class ErrorKind {
    different = 1,    // two runs that were compared are not the same
    interrupted = 3,  // stopped on request; the same command goes on
    usage = 64,       // wrong command line
    input = 65,       // invalid workflow, case or other data of the user
    missing = 66,     // an input file does not exist or cannot be read
    rendering = 69,   // no picture can be drawn on this machine
    numerics = 70,    // not positive definite, NaN, no convergence
    internal = 71,    // a bug in sigmaflow
    file = 73,        // a file cannot be written
    no_space = 74,    // the disk is full
    locked = 75,      // another process works on the same folder
};

class Error : public std::runtime_error {
public:
    Error(ErrorKind kind, std::string where, std::string what_is_wrong)
        : std::runtime_error(where.empty() ? what_is_wrong : where + ": " + what_is_wrong),
          kind_(kind),
          where_(std::move(where)),
          problem_(std::move(what_is_wrong))
    {
    }

    ErrorKind kind() const { return kind_; }
    const std::string& where() const { return where_; }
    const std::string& problem() const { return problem_; }

    /// The same error seen from further out: "outer: inner: problem".
    Error within(const std::string& outer) const
    {
        return Error(kind_, where_.empty() ? outer : outer + ": " + where_, problem_);
    }

private:
    ErrorKind kind_;
    std::string where_, problem_;
};

/// Several errors that were found together; kind and place are those of the first. what() has one
/// line for each.
class Errors : public Error {
public:
    explicit Errors(std::vector<Error> list)
        : Error(list.front().kind(), list.front().where(), joined(list)), list_(std::move(list))
    {
    }

    const std::vector<Error>& list() const { return list_; }

private:
    static std::string joined(const std::vector<Error>& list)
    {
        std::string text = list.front().problem();
        for (std::size_t k = 1; k < list.size(); ++k) text += "\n" + std::string(list[k].what());
        return text;
    }

    std::vector<Error> list_;
};

}
