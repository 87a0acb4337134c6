// Any bytes as a workflow file. The resolved workflow of an accepted one is a workflow file that
// resolves to itself.
#include "tests/fuzz/fuzzing.h"
#include "workflows/workflow.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count)
{
    using namespace sigmaflow;
    const std::string text = fuzzing::as_text(bytes, count);
    const auto workflow =
        fuzzing::accepted("fuzz", [&] { return workflows::parse_workflow(text, "fuzz"); });
    if (!workflow) return 0;
    const std::string resolved = workflow->resolved().dump();
    fuzzing::promise(workflows::parse_workflow(resolved, "again").resolved().dump() == resolved,
                     "a resolved workflow resolves to itself");
    return 0;
}
