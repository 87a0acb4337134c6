#include "workflows/folder_owner.h"

#include "engine/error.h"
#include "io/atomic_file.h"
#include "io/checksum.h"
#include "workflows/run_folder.h"

#include <signal.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>
#include <array>
#include <cerrno>
#include <cstdio>
#include <fstream>

namespace sigmaflow::workflows {

namespace fs = std::filesystem;

namespace {

constexpr const char* owner_name = "owner";

std::string this_host()
{
    std::array<char, 256> host{};
    return gethostname(host.data(), host.size() - 1) == 0 ? host.data() : "?";
}

std::string with_checksum(const std::string& line)
{
    return line + "\n" + io::hexadecimal(io::checksum(line)) + "\n";
}

bool is_alive(int process)
{
    return process > 0 && (::kill(process, 0) == 0 || errno == EPERM);
}

/// Does the kernel know of a lock on the folder? Inodes are unique within a device, and file
/// systems made of layers give the device of one of them: then the process must be the owner.
bool is_locked(const fs::path& folder, int owner)
{
    struct stat status {};
    if (::stat(folder.c_str(), &status) != 0) return false;
    std::ifstream locks("/proc/locks");
    for (std::string line; std::getline(locks, line);) {
        int process = 0;
        unsigned major = 0, minor = 0;
        unsigned long inode = 0;
        char kind[16] = "", mode[16] = "", access[16] = "";
        if (std::sscanf(line.c_str(), "%*d: %15s %15s %15s %d %x:%x:%lu", kind, mode, access,
                        &process, &major, &minor, &inode) != 7)
            continue;
        const bool same_device = major == ::major(status.st_dev) && minor == ::minor(status.st_dev);
        if (std::string(kind) == "FLOCK" && inode == status.st_ino &&
            (same_device || process == owner))
            return true;
    }
    return false;
}

}

void write_owner(const fs::path& folder)
{
    io::OutputFile file(folder / own_folder / owner_name);
    file.write(with_checksum("process " + std::to_string(getpid()) + " on " + this_host()));
    file.close();
}

FolderOwner read_owner(const fs::path& folder)
{
    std::string text;
    try {
        text = io::read_file(folder / own_folder / owner_name, 1000);
    } catch (const Error&) {
        return {};
    }
    FolderOwner owner;
    owner.text = text.substr(0, text.find('\n'));
    owner.whole = text == with_checksum(owner.text);
    std::array<char, 256> host{};
    if (std::sscanf(owner.text.c_str(), "process %d on %255s", &owner.process, host.data()) == 2)
        owner.host = host.data();
    return owner;
}

Writing is_written(const fs::path& folder)
{
    const FolderOwner owner = read_owner(folder);
    std::error_code error;
    if (fs::exists("/proc/locks", error)) {
        if (is_locked(folder, owner.process)) return Writing::yes;
    } else if (owner.host == this_host() && is_alive(owner.process)) {
        return Writing::yes;
    }
    return owner.host.empty() || owner.host == this_host() ? Writing::no : Writing::unknown;
}

void require_no_writer(const fs::path& folder)
{
    if (is_written(folder) == Writing::yes)
        throw Error(ErrorKind::locked, folder.string(),
                    read_owner(folder).text + " is writing to this folder");
}

}
