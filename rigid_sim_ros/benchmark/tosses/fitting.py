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

"""Friction and restitution that explain the tosses best, and how well on tosses not fitted."""

from dataclasses import dataclass

import numpy as np

from rigid_sim_ros.benchmark.tosses.scores import summary

SPLITS = 20
"""Random halves: parameters are chosen on one and scored on the other, both ways."""


@dataclass(frozen=True)
class Fit:
    """The best of the parameters that were tried."""

    parameters: dict
    fitted: tuple
    """Position [%], rotation [degrees] and right faces [%]: means over the tosses fitted to."""

    unseen: tuple
    """The same over tosses that the fit did not see, a mean over random halves."""


def best_fit(scores):
    """
    Return the `Fit` by least sum of position [%] and rotation [degrees] error.

    Parameters
    ----------
    scores : list of (dict, list of Score)
        What was tried, each scored on the same tosses in the same order.

    """
    cost = np.array([[row.position_percent + row.rotation_degrees for row in rows]
                     for _, rows in scores])
    best = int(cost.mean(axis=1).argmin())
    return Fit(parameters=scores[best][0], fitted=summary(scores[best][1]),
               unseen=_on_unseen(cost, [rows for _, rows in scores]))


def _on_unseen(cost, rows):
    """Return the mean summary of halves scored with the best parameters of the other half."""
    random = np.random.default_rng(0)
    count = cost.shape[1]
    if count < 2:
        return (np.nan,) * 3
    summaries = []
    for _ in range(SPLITS):
        order = random.permutation(count)
        halves = order[:count // 2], order[count // 2:]
        for seen, unseen in (halves, halves[::-1]):
            best = int(cost[:, seen].mean(axis=1).argmin())
            summaries.append(summary([rows[best][toss] for toss in unseen]))
    return tuple(np.mean(summaries, axis=0))
