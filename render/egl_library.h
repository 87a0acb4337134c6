// render/egl_library.h -- libEGL, loaded when the first picture is drawn.
#pragma once
#define EGL_NO_X11  // no X headers, no X names
#include <EGL/egl.h>
#include <EGL/eglext.h>

namespace sigmaflow::render {

/// The few EGL functions that an off-screen context needs, and the display that works here.
struct EglLibrary {
    decltype(&eglGetProcAddress) get_proc_address = nullptr;
    decltype(&eglQueryString) query_string = nullptr;
    decltype(&eglGetDisplay) get_display = nullptr;
    decltype(&eglInitialize) initialize = nullptr;
    decltype(&eglBindAPI) bind_api = nullptr;
    decltype(&eglChooseConfig) choose_config = nullptr;
    decltype(&eglCreateContext) create_context = nullptr;
    decltype(&eglDestroyContext) destroy_context = nullptr;
    decltype(&eglCreatePbufferSurface) create_pbuffer_surface = nullptr;
    decltype(&eglDestroySurface) destroy_surface = nullptr;
    decltype(&eglMakeCurrent) make_current = nullptr;
    decltype(&eglGetCurrentContext) get_current_context = nullptr;

    EGLDisplay display = EGL_NO_DISPLAY;
    EGLConfig config = nullptr;
};

/// Loaded and initialised once in the life of the process, never unloaded: EGL displays are shared
/// by the whole process, so ending one could pull it from under another window. Error: rendering
/// (libEGL is missing, no driver).
const EglLibrary& egl_library();

}
