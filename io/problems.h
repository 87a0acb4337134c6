// io/problems.h -- what is wrong with an input, all of it at once.
#pragma once
#include "engine/error.h"

#include <vector>

namespace sigmaflow::io {

/// Collects the errors (input) of checks that do not depend on each other; any other error passes.
class Problems {
public:
    /// False if the check failed. More than `most` errors are not looked for: they are thrown.
    template <class Check>
    bool collect(Check&& check)
    {
        try {
            check();
            return true;
        } catch (const Errors& errors) {
            for (const Error& error : errors.list()) add(error);
        } catch (const Error& error) {
            add(error);
        }
        return false;
    }

    /// Throws the error, or all of them as Errors, if there are any.
    void throw_all() const
    {
        if (list_.size() == 1) throw list_.front();
        if (!list_.empty()) throw Errors(list_);
    }

private:
    static constexpr std::size_t most = 50;

    void add(const Error& error)
    {
        if (error.kind() != ErrorKind::input) throw error;
        list_.push_back(error);
        if (list_.size() >= most) throw_all();
    }

    std::vector<Error> list_;
};

}
