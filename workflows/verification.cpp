#include "workflows/verification.h"

#include "io/atomic_file.h"
#include "io/sealed_file.h"
#include "workflows/checkpoint.h"
#include "workflows/folder_owner.h"
#include "workflows/manifest.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

namespace sigmaflow::workflows {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

struct Listed {
    std::uint64_t size = 0;
    std::string xxh3;
};

class Verifier {
public:
    explicit Verifier(const fs::path& folder) : folder_(folder) {}

    Verification result()
    {
        read_manifest();
        for (const fs::path& path : all_files()) {
            const std::string name = path.lexically_relative(folder_).generic_string();
            if (path.parent_path() == folder_ / own_folder ||
                path.parent_path().parent_path() == folder_ / own_folder)
                check_own(path, name);
            else if (name != manifest_name)
                others_.insert(name);
        }
        check_records_exist();
        for (const auto& [name, listed] : listed_) check_listed(name, listed);
        for (const std::string& name : others_)
            if (!compared_.contains(name)) found_.unlisted.push_back(name);
        for (const auto& [name, problem] : faults_) found_.faults.push_back({name, problem});
        return std::move(found_);
    }

private:
    void blame(const std::string& name, const std::string& problem)
    {
        faults_.try_emplace(name, problem);
    }

    void count(const std::string& name)
    {
        std::error_code error;
        const auto size = fs::file_size(folder_ / name, error);
        if (!compared_.insert(name).second) return;
        ++found_.files;
        if (!error) found_.bytes += size;
    }

    void list(const std::string& name, const Listed& listed)
    {
        const auto [entry, is_new] = listed_.try_emplace(name, listed);
        if (is_new || entry->second.xxh3 == listed.xxh3) return;
        blame(name, "has another checksum in manifest.json than in the record of its step");
    }

    void read_manifest()
    {
        found_.status = "unknown";
        count(manifest_name);
        std::string text;
        try {
            text = io::read_file(folder_ / manifest_name);
        } catch (const Error& error) {
            return blame(manifest_name, error.problem());
        }
        if (!seal_holds(text))
            return blame(manifest_name,
                         (text.find("\"seal\": ") == std::string::npos
                              ? std::string("has no seal: it was changed, or an earlier version of "
                                            "the program wrote it")
                              : std::string("was changed: its seal does not hold")) +
                             "; what it lists is taken from the records of the steps");
        const Json manifest = Json::parse(text);
        found_.status = manifest.at("status");
        // a run that was killed may have done more since
        if (found_.status == "running") return;
        for (const char* key : {"files", "files_of_run"})
            for (const Json& file : manifest.at(key))
                list(file.at("name"), {file.at("size"), file.at("xxh3")});
        for (const Json& step : manifest.at("steps"))
            if (found_.status != "pictures missing") finished_.push_back(step.at("name"));
    }

    std::vector<fs::path> all_files() const
    {
        std::vector<fs::path> files;
        std::error_code error;
        fs::recursive_directory_iterator entry(folder_, error);
        for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error))
            if (entry->is_symlink() || !entry->is_directory()) files.push_back(entry->path());
        if (error) throw Error(ErrorKind::missing, folder_.string(), error.message());
        std::sort(files.begin(), files.end());
        return files;
    }

    void check_own(const fs::path& path, const std::string& name)
    {
        try {
            if (path.parent_path() != folder_ / own_folder) {
                io::check_seal(io::sealed_content(path), name);
            } else if (path.filename() == "owner") {
                if (!read_owner(folder_).whole) blame(name, "was changed");
            } else if (path.extension() == record_ending) {
                check_record(path);
            } else if (path.stem() == "checkpoint") {
                check_checkpoint(path);
            } else {
                others_.insert(name);
                return;
            }
        } catch (const Error& error) {
            blame(name, error.problem());
        }
        count(name);
    }

    void check_record(const fs::path& path)
    {
        const StepRecord record = read_record(path);
        for (const ResultFile& file : record.files)
            list(file.name, {file.size, io::hexadecimal(file.digest)});
        recorded_.insert(record.identity.name);
    }

    void check_checkpoint(const fs::path& path)
    {
        for (const FileMark& file : read_checkpoint(path).files) {
            if (!is_inside(file.name)) continue;
            try {
                io::verify(folder_ / file.name, file.mark);
            } catch (const Error& error) {
                blame(file.name, error.problem());
            }
            count(file.name);
        }
    }

    void check_records_exist()
    {
        for (const std::string& step : finished_) {
            const std::string name = std::string(own_folder) + "/" + step + record_ending;
            if (!recorded_.contains(step)) blame(name, "is missing");
        }
    }

    void check_listed(const std::string& name, const Listed& listed)
    {
        count(name);
        std::error_code error;
        if (!is_inside(name) || !fs::is_regular_file(folder_ / name, error))
            return blame(name, "is missing");
        const auto size = fs::file_size(folder_ / name, error);
        if (error || size != listed.size)
            return blame(name, "was changed: it has " + std::to_string(size) + " bytes, not " +
                                   std::to_string(listed.size));
        if (io::hexadecimal(io::file_checksum(folder_ / name)) != listed.xxh3)
            blame(name, "was changed: its checksum is another one");
    }

    fs::path folder_;
    Verification found_;
    std::map<std::string, Listed> listed_;
    std::map<std::string, std::string> faults_;
    std::set<std::string> compared_, others_, recorded_;
    std::vector<std::string> finished_;
};

}

Verification verify_folder(const fs::path& folder)
{
    std::error_code error;
    if (!fs::exists(folder, error))
        throw Error(ErrorKind::missing, folder.string(), "cannot be read: no such folder");
    if (!fs::is_directory(folder / own_folder, error) && !fs::exists(folder / manifest_name, error))
        throw Error(ErrorKind::input, folder.string(), "is not the folder of a run");
    require_no_writer(folder);
    return Verifier(folder).result();
}

}
