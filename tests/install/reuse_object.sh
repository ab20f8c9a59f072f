#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Before a compiler: takes the object that another build of the same tree has of the same file, if there is one.
#   reuse_object.sh BUILD TREE COPY COMPILER... -o OBJECT -c COPY/FILE
build=$1 tree=$2 copy=$3
shift 3
object='' file='' before=''
for argument; do
    [ "$before" = -o ] && object=$argument
    [ "$before" = -c ] && file=$argument
    before=$argument
done
if [ -f "$build/$object" ] && [ "$file" != "${file#"$copy"/}" ] && cmp -s "$file" "$tree/${file#"$copy"/}"; then
    exec cp "$build/$object" "$object"
fi
exec "$@"
