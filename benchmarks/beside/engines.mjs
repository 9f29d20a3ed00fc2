// The cradle between two walls in physics engines of the web:  node engines.mjs < setup.json > results.json
// An engine here is a function of the setup that gives {step, positions, velocities, push}; lengths are metres, masses 1 kg.

import { readFileSync } from "node:fs";
import RAPIER from "@dimforge/rapier2d-compat";
import Matter from "matter-js";
import * as planck from "planck";

const PIXELS = 1000; // pixels of matter-js in a metre; in it contacts slower than 2 pixels per step do not bounce
const WALL = 0.5; // half the width of a wall

function box2d({ places, speeds, walls, radius, step, rigid }) {
  planck.Settings.velocityThreshold = 0; // else contacts slower than 1 m/s do not bounce
  const world = new planck.World({ gravity: planck.Vec2(0, 0) });
  for (const x of walls) world.createBody({ position: planck.Vec2(x, 0) }).createFixture(new planck.Box(WALL, 5), { restitution: 1, friction: 0 });
  const balls = places.map((x, k) => {
    const ball = world.createDynamicBody({ position: planck.Vec2(x, 0), fixedRotation: true, bullet: rigid, allowSleep: false });
    ball.createFixture(new planck.Circle(radius), { density: 1 / (Math.PI * radius ** 2), restitution: 1, friction: 0, isSensor: !rigid });
    ball.setLinearVelocity(planck.Vec2(speeds[k], 0));
    return ball;
  });
  return { step: () => world.step(step), positions: () => balls.map((ball) => ball.getPosition().x),
    velocities: () => balls.map((ball) => ball.getLinearVelocity().x), push: (forces) => balls.forEach((ball, k) => ball.applyForceToCenter(planck.Vec2(forces[k], 0))) };
}

function rapier({ places, speeds, walls, radius, step, rigid }) {
  const world = new RAPIER.World({ x: 0, y: 0 });
  world.timestep = step;
  const bouncing = (shape) => shape.setRestitution(1).setFriction(0);
  for (const x of walls) world.createCollider(bouncing(RAPIER.ColliderDesc.cuboid(WALL, 5)).setTranslation(x, 0));
  const balls = places.map((x, k) => {
    const ball = world.createRigidBody(RAPIER.RigidBodyDesc.dynamic().setTranslation(x, 0).setLinvel(speeds[k], 0).lockRotations().setCanSleep(false).setCcdEnabled(rigid));
    world.createCollider(bouncing(RAPIER.ColliderDesc.ball(radius)).setMass(1).setSensor(!rigid), ball);
    return ball;
  });
  return { step: () => { world.step(); balls.forEach((ball) => ball.resetForces(true)); }, positions: () => balls.map((ball) => ball.translation().x),
    velocities: () => balls.map((ball) => ball.linvel().x), push: (forces) => balls.forEach((ball, k) => ball.addForce({ x: forces[k], y: 0 }, true)) };
}

function matter({ places, speeds, walls, radius, step, rigid }) {
  const engine = Matter.Engine.create({ gravity: { x: 0, y: 0 }, enableSleeping: false }), milliseconds = 1000 * step;
  const bouncing = { restitution: 1, friction: 0, frictionStatic: 0, frictionAir: 0, slop: 0, isSensor: !rigid };
  const unit = PIXELS * 1000 / 60 / 1000; // unit of speed: pixels in a sixtieth of a second
  const balls = places.map((x, k) => {
    const ball = Matter.Bodies.circle(PIXELS * x, 0, PIXELS * radius, { ...bouncing, inertia: Infinity });
    Matter.Body.setMass(ball, 1);
    Matter.Body.setVelocity(ball, { x: speeds[k] * unit, y: 0 });
    return ball;
  });
  Matter.Composite.add(engine.world, [...balls, ...walls.map((x) => Matter.Bodies.rectangle(PIXELS * x, 0, 2 * WALL * PIXELS, 1000, { ...bouncing, isStatic: true }))]);
  return { step: () => Matter.Engine.update(engine, milliseconds), positions: () => balls.map((ball) => ball.position.x / PIXELS),
    velocities: () => balls.map((ball) => Matter.Body.getVelocity(ball).x / unit),
    push: (forces) => balls.forEach((ball, k) => { ball.force.x = forces[k] * PIXELS * 1e-6; }) }; // per millisecond squared
}

// Forces of soft contacts, of balls and with the walls, each f0 * overlap ** alpha.
function softForces(x, { radius, walls, law }) {
  const forces = x.map(() => 0), press = (overlap) => (overlap > 0 ? law[0] * overlap ** law[1] : 0);
  for (let k = 0; k + 1 < x.length; k++) {
    const force = press(2 * radius - (x[k + 1] - x[k]));
    forces[k] -= force;
    forces[k + 1] += force;
  }
  forces[0] += press(walls[0] + WALL + radius - x[0]);
  forces[x.length - 1] -= press(x.at(-1) - (walls[1] - WALL - radius));
  return forces;
}

const stored = (x, { radius, walls, law }) => {
  const depths = x.slice(1).map((right, k) => 2 * radius - (right - x[k]));
  depths.push(walls[0] + WALL + radius - x[0], x.at(-1) - (walls[1] - WALL - radius));
  return depths.reduce((sum, d) => sum + (d > 0 ? law[0] * d ** (1 + law[1]) / (1 + law[1]) : 0), 0);
};

// Step on until `most` collisions have been counted: pairs whose gap closes after it was open.
function run(make, setup) {
  const world = make(setup), { step, radius, rigid, most, first, longest, touching } = setup;
  let collisions = 0, ordered = true, early = null, time = 0;
  let open = setup.places.slice(1).map(() => false);
  while (collisions < most && time < longest) {
    if (!rigid) world.push(softForces(world.positions(), setup));
    world.step();
    time += step;
    const x = world.positions();
    const gaps = x.slice(1).map((right, k) => right - x[k] - 2 * radius);
    ordered &&= gaps.every((gap) => gap > -2 * radius);
    open = gaps.map((gap, k) => { if (open[k] && gap < touching) { collisions += 1; return false; } return open[k] || gap > 2 * touching; });
    if (early === null && time >= first) early = world.velocities();
    if (!x.every(Number.isFinite)) break;
  }
  const v = world.velocities(), x = world.positions();
  const energy = v.reduce((sum, w) => sum + 0.5 * w * w, 0) + (rigid ? 0 : stored(x, setup));
  return { first: early, collisions, time, ordered, energy, velocities: v };
}

await RAPIER.init();
const setups = JSON.parse(readFileSync(0, "utf8")), engines = { planck: box2d, rapier2d: rapier, "matter-js": matter };
const found = setups.map((setup) => Object.fromEntries(Object.entries(engines).map(([name, make]) => [name, run(make, setup)])));
process.stdout.write(JSON.stringify(found));
