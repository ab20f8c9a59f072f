// SPDX-License-Identifier: Apache-2.0
#include "ocio/read_config.h"

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN

OCIO::ConfigRcPtr editable_copy(const OCIO::Config& config) {
    const OCIO::ConfigRcPtr copy = config.createEditableCopy();
    copy->setDefaultViewTransformName(config.getDefaultViewTransformName());
    return copy;
}

OCIO::ConfigRcPtr read_config(const std::string& path) {
    try {
        const OCIO::ConfigRcPtr config = editable_copy(*OCIO::Config::CreateFromFile(path.c_str()));
        config->setProcessorCacheFlags(OCIO::PROCESSOR_CACHE_OFF);
        return config;
    } catch (const OCIO::Exception& e) {
        throw FileError("read: " + path + ": " + e.what());
    }
}

TONEWRIGHT_NAMESPACE_END
