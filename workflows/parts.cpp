#include "workflows/parts.h"

#include "io/sealed_file.h"
#include "workflows/checkpoint.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <thread>

namespace sigmaflow::workflows {

namespace fs = std::filesystem;

namespace {

constexpr io::Seal seal{"part of a step", 1};
constexpr const char* parts_ending = ".parts";

struct Part {
    std::string key, bytes;
};

template <class Archive>
void archive(Archive& a, Part& part)
{
    a(part.key, part.bytes);
}

std::optional<std::string> stored_part(const fs::path& path, const std::string& key)
{
    if (!fs::exists(path)) return std::nullopt;
    try {
        const std::string bytes = io::read_sealed(path, seal);
        Part part;
        ArchiveReader a(bytes);
        a(part);
        a.finish();
        if (part.key == key) return part.bytes;
    } catch (const Error&) {  // computed again
    }
    return std::nullopt;
}

}

Parts::Parts(const Context& context)
    : folder_(context.folder.own_file(context.step_name + parts_ending)),
      key_(context.keeper.step().key)
{
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error)
        throw Error(error == std::errc::no_space_on_device ? ErrorKind::no_space : ErrorKind::file,
                    folder_.string(), "cannot make the folder: " + error.message());
}

std::string Parts::compute(const std::string& name, const std::function<std::string()>& work) const
{
    const fs::path path = folder_ / name;
    if (auto stored = stored_part(path, key_)) return std::move(*stored);
    Part part{key_, work()};
    ArchiveWriter a;
    a(part);
    io::write_sealed(path, seal, a.bytes());
    return std::move(part.bytes);
}

void remove_parts(const RunFolder& folder, const std::string& step)
{
    std::error_code ignored;
    fs::remove_all(folder.own_file(step + parts_ending), ignored);
}

void remove_other_parts(const RunFolder& folder, const std::vector<std::string>& steps)
{
    std::vector<std::string> others;
    for (const auto& entry : fs::directory_iterator(folder.own_file(""))) {
        const std::string step = entry.path().stem().string();
        if (entry.path().extension() == parts_ending &&
            std::find(steps.begin(), steps.end(), step) == steps.end())
            others.push_back(step);
    }
    for (const std::string& step : others) remove_parts(folder, step);
}

void compute_side_by_side(Context& context, int count,
                          const std::function<void(int, const Pulse&)>& work)
{
    std::atomic<int> next = 0, done = 0, working = 0;
    std::atomic<bool> stop = false;
    std::mutex mutex;
    std::exception_ptr failure;
    const Pulse pulse = [&] {
        if (stop) throw Stopped{};
    };
    const auto labour = [&] {
        try {
            for (int k; !stop && (k = next++) < count; ++done) work(k, pulse);
        } catch (const Stopped&) {
        } catch (...) {
            const std::lock_guard lock(mutex);
            if (!failure) failure = std::current_exception();
            stop = true;
        }
        --working;
    };
    std::vector<std::jthread> threads;
    working = std::min(std::max(1, context.threads), count);
    for (int i = working; i > 0; --i) threads.emplace_back(labour);
    try {
        while (working > 0) {
            std::this_thread::sleep_for(std::chrono::milliseconds(20));  // stored parts are read
            context.progress.update(static_cast<double>(done) / count,
                                    std::to_string(done) + " of " + std::to_string(count));
            context.keeper.stop_if_asked("goes on with the parts that are missing");
        }
    } catch (...) {
        stop = true;
        threads.clear();  // waits
        throw;
    }
    threads.clear();
    if (failure) std::rethrow_exception(failure);
}

}
