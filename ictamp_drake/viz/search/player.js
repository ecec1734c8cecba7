// Moves the bodies of Meshcat's scene by recorded motions, one after the other.
class Player {
  // scene: paths of the bodies, units of times and poses, motions. listener: called after each change of the time.
  constructor(scene, listener) {
    this.scene = scene;
    this.paths = scene.bodies.map(path => path.split("/").slice(1));
    this.listener = listener;
    this.speed = 1;
    this.load([scene.root]);
    requestAnimationFrame(now => this.tick(now, now));
  }

  // Take motions that follow each other, and show where the last one ends.
  load(motions) {
    this.motions = motions;
    this.starts = [];
    this.duration = 0;
    for (const motion of motions) {
      this.starts.push(this.duration);
      this.duration += motion.end;
    }
    this.stop_at(this.duration);
  }

  // Stand still at a time [s].
  stop_at(time) {
    this.time = time;
    this.playing = false;
    this.listener(this);
  }

  // Go on, at the end from the start again; speed: seconds of the recording in a second.
  play(speed) {
    if (this.time === this.duration) {
      this.time = 0;
    }
    this.speed = speed;
    this.playing = true;
    this.listener(this);
  }

  // Number of the motion at hand, and the time since its start [s].
  get at() {
    const last = this.starts.findLastIndex(start => start <= this.time);
    return [last, this.time - this.starts[last]];
  }

  tick(before, now) {
    if (this.playing) {
      this.time = Math.min(this.duration, this.time + this.speed * (now - before) / 1000);
      this.playing = this.time < this.duration;
      this.listener(this);
    }
    this.show();
    requestAnimationFrame(next => this.tick(now, next));
  }

  // Meshcat's own commands come late and may move a body, too, so it is looked at every time where each one is.
  show() {
    const [number, time] = this.at;
    this.motions[number].tracks.forEach((track, body) => {
      const [w, x, y, z, ...position] = this.pose(track, time);
      const quaternion = new MeshCat.THREE.Quaternion(x, y, z, w).normalize();
      const object = viewer.scene_tree.find(this.paths[body]).object;
      const place = new MeshCat.THREE.Vector3(...position);
      if (!object.position.equals(place) || !object.quaternion.equals(quaternion)) {
        object.position.copy(place);
        object.quaternion.copy(quaternion);
        viewer.set_dirty();
      }
    });
  }

  // Quaternion (not of unit length) and position [m] at a time: straight between two keys.
  pose([times, numbers], time) {
    const [time_unit, pose_unit] = this.scene.units;
    const ticks = time / time_unit;
    const before = times.findLastIndex(key => key <= ticks);
    const after = Math.min(before + 1, times.length - 1);
    const share = after > before ? (ticks - times[before]) / (times[after] - times[before]) : 0;
    return Array.from({length: 7}, (_, i) => {
      const [start, end] = [numbers[7 * before + i], numbers[7 * after + i]];
      return pose_unit * (start + share * (end - start));
    });
  }
}
