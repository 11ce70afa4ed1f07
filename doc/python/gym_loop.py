#!/usr/bin/python3
"""An environment as reinforcement learning wants it (reset, step), and a policy that presses until 0.1 N is reached."""
import numpy as np

import tissue_contact as tc


class PressEnvironment:
    def __init__(self, scene="package://tissue_contact/config/press_drag.yaml", wanted_n=0.1):
        self.simulator, self.wanted_n = tc.Simulator(tc.load_scene(scene)), wanted_n
        self.simulator.place("probe", [0.0, 0.0, -0.01])
        self.start = self.simulator.save_state()

    def reset(self):
        self.simulator.load_state(self.start)
        return self.observation()

    def observation(self):
        return np.concatenate([self.simulator.joint_positions("probe"), self.simulator.wrench("probe", frame="world")[:3]])

    def step(self, action):  # m, change of x, y, z within 10 ms
        self.simulator.advance(0.01, {"probe": self.simulator.joint_positions("probe") + np.clip(action, -0.0002, 0.0002)})
        error_n = self.wanted_n - self.observation()[5]
        return self.observation(), -abs(error_n), abs(error_n) < 0.005, self.simulator.report().implausible_load


if __name__ == "__main__":
    environment = PressEnvironment()
    for episode in range(2):
        seen, done, steps, total = environment.reset(), False, 0, 0.0
        while not done and steps < 300:
            seen, reward, done, truncated = environment.step([0.0, 0.0, -0.0005 * (environment.wanted_n - seen[5]) / environment.wanted_n])
            steps, total = steps + 1, total + reward
        print("episode %d: %.4f N after %d steps, return %.6f" % (episode, seen[5], steps, total))
