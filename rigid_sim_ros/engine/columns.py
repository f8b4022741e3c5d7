# Copyright 2026 The rigid_sim_ros authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Columns of arrays that have one for each body."""


def columns_of(indices):
    """
    Return ascending indices (k,) as a slice if they follow each other, or as they are.

    Columns are taken and replaced by a slice in a fraction of the time; what is taken is a view.
    """
    count = len(indices)
    if count and indices.item(count - 1) - indices.item(0) == count - 1:
        return slice(indices.item(0), indices.item(0) + count)
    return indices
