// render/egl_library.cpp
#include "render/egl_library.h"

#include "engine/error.h"

#include <dlfcn.h>
#include <cstring>
#include <string>
#include <vector>

namespace sigmaflow::render {
namespace {

Error no_driver(const std::string& problem)
{
    return Error(ErrorKind::rendering, "off-screen window",
                 problem + "; install the packages libegl1 and libgl1-mesa-dri");
}

EglLibrary load()
{
    void* handle = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    if (!handle) throw no_driver(std::string("libEGL cannot be loaded (") + dlerror() + ")");
    EglLibrary egl;
    const auto find = [&](const char* name, auto& function) {
        function =
            reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(handle, name));
        if (!function) throw no_driver(std::string("libEGL lacks the function ") + name);
    };
    find("eglGetProcAddress", egl.get_proc_address);
    find("eglQueryString", egl.query_string);
    find("eglGetDisplay", egl.get_display);
    find("eglInitialize", egl.initialize);
    find("eglBindAPI", egl.bind_api);
    find("eglChooseConfig", egl.choose_config);
    find("eglCreateContext", egl.create_context);
    find("eglDestroyContext", egl.destroy_context);
    find("eglCreatePbufferSurface", egl.create_pbuffer_surface);
    find("eglDestroySurface", egl.destroy_surface);
    find("eglMakeCurrent", egl.make_current);
    find("eglGetCurrentContext", egl.get_current_context);
    return egl;
}

/// In the order of preference: no window system at all, a device (GPU), what the system suggests.
std::vector<EGLDisplay> candidate_displays(const EglLibrary& egl)
{
    std::vector<EGLDisplay> candidates;
    const char* extensions = egl.query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    const auto has = [&](const char* name) { return extensions && std::strstr(extensions, name); };
    const auto platform_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
        egl.get_proc_address("eglGetPlatformDisplayEXT"));
    if (platform_display && has("EGL_MESA_platform_surfaceless"))
        candidates.push_back(
            platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
    const auto query_devices =
        reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(egl.get_proc_address("eglQueryDevicesEXT"));
    if (platform_display && query_devices && has("EGL_EXT_platform_device")) {
        EGLDeviceEXT devices[16];
        EGLint count = 0;
        if (query_devices(16, devices, &count))
            for (int i = 0; i < count; ++i)
                candidates.push_back(
                    platform_display(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr));
    }
    candidates.push_back(egl.get_display(EGL_DEFAULT_DISPLAY));
    return candidates;
}

bool find_config(EglLibrary& egl, EGLDisplay display)
{
    const EGLint wanted[] = {EGL_SURFACE_TYPE,
                             EGL_PBUFFER_BIT,
                             EGL_RENDERABLE_TYPE,
                             EGL_OPENGL_BIT,
                             EGL_RED_SIZE,
                             8,
                             EGL_GREEN_SIZE,
                             8,
                             EGL_BLUE_SIZE,
                             8,
                             EGL_ALPHA_SIZE,
                             8,
                             EGL_NONE};
    EGLint count = 0;
    return egl.choose_config(display, wanted, &egl.config, 1, &count) && count > 0;
}

EglLibrary loaded_and_initialised()
{
    EglLibrary egl = load();
    bool initialised = false;
    for (EGLDisplay display : candidate_displays(egl)) {
        EGLint major = 0, minor = 0;
        if (display == EGL_NO_DISPLAY || !egl.initialize(display, &major, &minor)) continue;
        initialised = true;
        if (!find_config(egl, display)) continue;
        egl.display = display;
        return egl;
    }
    throw no_driver(initialised ? "no EGL display offers desktop OpenGL"
                                : "no EGL display can be initialised");
}

}

const EglLibrary& egl_library()
{
    static const EglLibrary library = loaded_and_initialised();  // tried again after an exception
    return library;
}

}
