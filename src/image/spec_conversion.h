// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imageio.h>

#include <string_view>

#include "picture/picture_spec.h"

/// The same spec for OpenImageIO and for code without it.
TONEWRIGHT_NAMESPACE_BEGIN

/// Loses nothing but what no reader sets: the interpolation of an attribute.
[[nodiscard]] TONEWRIGHT_API PictureSpec picture_spec(const OIIO::ImageSpec& spec);
[[nodiscard]] TONEWRIGHT_API OIIO::ImageSpec image_spec(const PictureSpec& spec);

/// Changes a spec by a function of code without OpenImageIO.
/// @param change  takes a PictureSpec&
template <class Change>
void change_spec(OIIO::ImageSpec& spec, const Change& change) {
    PictureSpec changed = picture_spec(spec);
    change(changed);
    spec = image_spec(changed);
}

/// Removes an attribute, and needs no memory for it. Where memory runs out,
/// ImageSpec::erase_attribute() says nothing and leaves a list with other attributes than before.
TONEWRIGHT_API void erase_attribute(OIIO::ImageSpec& spec, std::string_view name);

TONEWRIGHT_NAMESPACE_END
