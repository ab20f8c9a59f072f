// SPDX-License-Identifier: Apache-2.0
#pragma once

#ifdef TONEWRIGHT_HAVE_LCMS2

#include <lcms2.h>

#include <memory>
#include <new>
#include <string>
#include <type_traits>

#include "tonewright/version.h"

/// Objects of LittleCMS that free themselves.
TONEWRIGHT_NAMESPACE_BEGIN

struct IccDeleter {
    void operator()(void* p) const { cmsCloseProfile(p); }
    void operator()(cmsPipeline* p) const { cmsPipelineFree(p); }
    void operator()(cmsMLU* p) const { cmsMLUfree(p); }
    void operator()(cmsSEQ* p) const { cmsFreeProfileSequenceDescription(p); }
    void operator()(cmsToneCurve* p) const { cmsFreeToneCurve(p); }
};
template <class T>
using IccOwned = std::unique_ptr<T, IccDeleter>;
using IccContext = std::unique_ptr<std::remove_pointer_t<cmsContext>, decltype(&cmsDeleteContext)>;

/// A context of its own, so that no error reaches a handler of the process.
/// @param message  gets the first error; must live as long as the context
inline IccContext make_icc_context(std::string& message) {
    IccContext context(cmsCreateContext(nullptr, &message), &cmsDeleteContext);
    if (!context) throw std::bad_alloc();
    cmsSetLogErrorHandlerTHR(context.get(), [](cmsContext of, cmsUInt32Number, const char* text) {
        auto* kept = static_cast<std::string*>(cmsGetContextUserData(of));
        if (kept->empty()) *kept = text;
    });
    return context;
}

TONEWRIGHT_NAMESPACE_END

#endif
