// Any bytes as a checkpoint. The first byte says how far they get: 0 as a file, 1 as the content of a
// file whose checksum is right, 2 and 3 as the state and the memory of a run (pcg, lagged_cholesky).
// A run that is restored can be stored again and take a step.
#include "engine/memory.h"
#include "engine/step.h"
#include "io/sealed_file.h"
#include "tests/fuzz/fuzzing.h"
#include "workflows/checkpoint.h"

using namespace sigmaflow;

namespace {

bool read_file(const std::string& content)
{
    workflows::parse_checkpoint(content, "fuzz");
    return true;
}

bool restore(const std::string& content, SolverKind solver)
try {
    ArchiveReader a(content);
    State state;
    a(state);
    check_stored_state(state);
    Workspace workspace({solver, 1e-3});
    const Model model;
    restore_memory(state, model, workspace, a);
    a.finish();
    ArchiveWriter again;
    again(state);
    save_memory(state, workspace, again);
    try {
        advance(state, model, ImposedStress{3}, {Scheme::implicit, 1e-2}, {1, 1}, workspace);
    } catch (const Error& error) {  // a state that cannot move
        if (error.kind() != ErrorKind::numerics) throw;
    }
    return true;
} catch (const Error& error) {
    if (error.kind() == ErrorKind::numerics) throw Error(ErrorKind::input, "fuzz", "cannot move");
    throw error.within("fuzz");
}

}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count)
{
    if (count == 0) return 0;
    const std::string content = fuzzing::as_text(bytes + 1, count - 1);
    fuzzing::accepted("fuzz", [&] {
        switch (bytes[0] % 4) {
            case 0:
                return read_file(content);
            case 1:
                return read_file(io::sealed({"checkpoint", 1}, content));
            case 2:
                return restore(content, SolverKind::pcg);
            default:
                return restore(content, SolverKind::lagged_cholesky);
        }
    });
    return 0;
}
