// workflows/parts.h -- a long step made of parts that do not depend on each other's files.
//
// The result of each finished part is stored in .sigmaflow/<step>.parts/, with the key of the step,
// so a step that was interrupted goes on with the parts that are missing; a part on its way is
// begun anew. Parts of another key (a changed parameter) and damaged ones are computed again. All
// are removed when the step is finished. Errors: file, no_space; interrupted.
#pragma once
#include "engine/archive.h"
#include "workflows/step.h"

#include <filesystem>
#include <functional>
#include <string>
#include <type_traits>

namespace sigmaflow::workflows {

class Parts {
public:
    /// Of the running step.
    explicit Parts(const Context& context);

    /// The stored bytes of the part, or those that `work` returns, stored. Different parts may be
    /// computed at the same time.
    std::string compute(const std::string& name, const std::function<std::string()>& work) const;
    /// The same for what can be archived.
    template <class Work>
    auto value(const std::string& name, Work&& work) const
    {
        std::invoke_result_t<Work> result;
        const std::string bytes = compute(name, [&] {
            auto computed = work();
            ArchiveWriter a;
            a(computed);
            return a.bytes();
        });
        ArchiveReader a(bytes);
        a(result);
        return result;
    }

private:
    std::filesystem::path folder_;
    std::string key_;
};

void remove_parts(const RunFolder& folder, const std::string& step);
/// Those of all steps but the named ones.
void remove_other_parts(const RunFolder& folder, const std::vector<std::string>& steps);

/// work(k, pulse) for k = 0 ... count - 1, context.threads at a time. `work` calls pulse() at least
/// every second: it throws Stopped when the run was asked to stop or another part has failed. The
/// first error of a part is thrown when all have ended.
struct Stopped {};
using Pulse = std::function<void()>;
void compute_side_by_side(Context& context, int count,
                          const std::function<void(int, const Pulse&)>& work);

}
